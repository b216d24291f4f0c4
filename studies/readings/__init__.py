"""Which reading of the FRA-NBV paper makes its table: what its text leaves open, searched by an experiment."""
