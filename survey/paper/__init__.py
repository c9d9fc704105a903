"""The results of [Lisenko2017] computed anew: figures 1-3, the six depths, the receiver they need.

[Lisenko2017]: A. A. Lisenko, A. I. Potekaev, V. S. Shamanaev, "Statistical estimates of the signals
of a lidar with a matrix photodetector reflected from the sea bottom", Russian Physics Journal
(2017).
"""
