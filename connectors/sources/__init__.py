"""SOURCES: where recorded loops lie, a file each: exports, historians and databases behind one interface."""
