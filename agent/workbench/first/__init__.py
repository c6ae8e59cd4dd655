"""What is done with an effect before its whole search, each once: first fits, inputs by chance, valves."""
