"""Plants whose process is nonlinear, by the balances of textbooks."""
