"""ONE LOOP: samples in, windows out, diagnosed in worker processes, the alarm that follows."""
