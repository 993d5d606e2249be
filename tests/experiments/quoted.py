"""What Aleotti & Caselli 2005 print, section IV: quoted, never computed here."""

from __future__ import annotations

# Table I: cluster -> (demonstration, log-probability), best first.
TABLE_1 = {
    1: ((10, -180.253), (12, -185.522), (6, -199.228), (1, -203.882), (8, -214.307)),
    2: ((11, -152.138), (5, -213.171), (2, -231.993)),
    3: ((3, -118.992), (7, -192.809), (4, -200.911), (9, -203.675)),
}
SUMS = {cluster: sum(value for _, value in rows) for cluster, rows in TABLE_1.items()}
ITERATIONS = 4  # "converges in 4 iterations"
REJECTED_SHARE = 0.94  # of 1000 repetitions on one data set
