"""Which couplings and stiffnesses put the modes where they should be. All values in SI.

==============  ==================================================================================
module          responsibility
==============  ==================================================================================
`options`       what may be chosen: options of the rows of `Tuning` and `Catalogue`, and the case
                that they make
`checks`        checks of the rows of `Tuning` and `Catalogue`: what is wrong is reported all at once,
                with what to do
`combinations`  what is to be tried: every combination of the options, and the unchanged case
`evaluate`      one combination of a tuning study, calculated: what a designer compares couplings
                by
`maps`          the map of a tuning study: starts and margins over the first two variables, or the
                only one
`ranking`       which combination is better, and why: the order of a tuning study, and its reasons
                in words
`tuning`        where to put the modes: every combination of couplings calculated, ranked, and the
                reasons told
==============  ==================================================================================
"""
