"""What several stiction detectors share: half cycles, cycles of OP and PV, the stem, waves."""
