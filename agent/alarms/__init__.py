"""The ISA-18.2 alarm life cycle; pure."""
