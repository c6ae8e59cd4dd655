"""The YAML file as models; reports every fault at once, each with its path."""
