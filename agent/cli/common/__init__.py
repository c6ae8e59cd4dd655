"""What several commands share: recordings as arguments, pictures, errors, logs, the stage of the demo."""
