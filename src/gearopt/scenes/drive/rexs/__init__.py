"""REXS, the exchange format of gear units (FVA): read as a problem file, written from an answer.

`attributes.csv` has the attributes that are read or written, of REXS 2.0.0: components that have
it, id, unit, sort, range and ids of earlier versions. Ids and units are facts of the schema in
github.com/fva-net/rexs-api-java (Apache-2.0).
"""
