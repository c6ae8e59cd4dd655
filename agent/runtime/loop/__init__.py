"""ONE LOOP: windows that are due, diagnosed in worker processes, the alarm that follows."""
