"""Elastic teeth of spur gears: the compliance of a pair of teeth in contact, simple to exact.

`elastic.ElasticPair` says what deforms, `ladder.LEVELS` holds the models, all of one signature;
`ladder.COUPLINGS` how far one pair of teeth gives way under the load of its neighbour. Compliances
in mm/N along the line of action, of the whole face width.
"""
