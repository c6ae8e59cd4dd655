"""EXPORTS: files of historians and spreadsheets, in one reader that guesses and shows its guess."""
