"""A file as a table: unpacked, decoded, cut into cells, its header found."""
