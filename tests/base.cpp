// Nothing: its target makes the header ready that all tests include.
