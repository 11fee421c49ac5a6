"""From a stress history to allowable starts. Stress in Pa, zero-to-peak unless named otherwise.

==================  ==============================================================================
module              responsibility
==================  ==============================================================================
`cycle_counting`    cycles of a history: rainflow (ASTM E1049-85), and the paper's count of Figure
                    3
`stress`            nominal stress of a shaft section, and the maximum shear theory. Torque in N
                    m, stress in Pa
`sn_curve`          the S-N line of a material in torsion: log-log through points, endurance,
                    bending halved
`notches`           stress concentration of fillets and keyways in torsion, and how much of it
                    fatigue feels
`strength_factors`  surface, size and reliability factors, and the S-N line that they lower
`mean_stress`       mean stress of a cycle: the reversed cycle that damages as much
`shaft_strength`    what the fatigue of one shaft is judged with: its notch, the factors on its
                    strength, its S-N line and mean stress
`damage`            damage of counted cycles: Palmgren-Miner sum, its interval, and the starts it
                    allows
`allowable_starts`  fatigue of the judged shafts in one start: damage, permitted starts, and what
                    a reader must know
==================  ==============================================================================
"""
