"""Trains in the files of others: tables of text, openTorsion and ROSS. Numbers keep the unit in which they stand.

===============  =================================================================================
module           responsibility
===============  =================================================================================
`foreign`        a train as another file has it: its rows, where each stands, what was left out
`chains`         trains whose stations stand in one row, and what other formats have no place for
`table_headers`  names and units above the columns of a table of text
`text_tables`    tables of stations and elements as text (CSV, clipboard) ↔ rows of a case
`opentorsion`    openTorsion's file of components (TORS, JSON) ↔ rows of a case
`ross`           a rotor that ROSS saved (TOML, JSON) ↔ rows of a case
`read_train`     any of them → `CaseInput`, checked as every input is
===============  =================================================================================
"""
