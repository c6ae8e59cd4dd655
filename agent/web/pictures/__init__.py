"""PICTURES: numbers, pictures and prints of one diagnosis, made on demand in a process of their own."""
