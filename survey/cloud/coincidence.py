"""How many frames must agree before a weak echo is a bottom.

Binary integration, "M of N" (M. A. Richards, Fundamentals of Radar Signal Processing, chapter 6):
each flash decides for itself at a lax rate p, and what so many of them say is believed. Here the
flashes look from elsewhere, so that one agrees if any of its pixels near the place does:

1. A pixel has a false candidate with a probability of at most p, anywhere in the depth D that is
   searched, each depth alike.
2. Another frame has n pixels within reach of it, each with a false candidate with at most p.
   That one of them lies within t above or below has a probability of at most q = n p 2 t / D.
3. Flashes are independent: M or more of the N others that look there agree by chance with the
   probability of the binomial distribution, P(B(N, q) >= M).

So p P(B(N, q) >= M) bounds the false bottoms of a pixel and flash. M is the least number that keeps
this within the stated false-alarm rate.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import binom

FloatArray = NDArray[np.float64]
Whole = NDArray[np.int64]


@dataclass(frozen=True, kw_only=True)
class Coincidence:
    """The rule by which frames believe each other.

    Parameters
    ----------
    candidate_rate : float
        p: probability of a false candidate, of a pixel and flash [1].
    false_alarm_rate : float
        Highest probability of a candidate that is believed falsely, of a pixel and flash [1].
    depth_searched : float
        D: over which false candidates are spread [m].
    """

    candidate_rate: float
    false_alarm_rate: float
    depth_searched: float

    def chance(self, *, pixels: FloatArray, tolerance: FloatArray) -> FloatArray:
        """Return q, the probability at which another frame agrees by chance (n,) [1].

        Parameters
        ----------
        pixels : array (n,)
            Of that frame within reach.
        tolerance : array (n,)
            By how much elevations may differ to either side [m].
        """
        share = np.minimum(2.0 * tolerance / self.depth_searched, 1.0)
        return np.minimum(pixels * self.candidate_rate * share, 1.0)

    def needed(self, *, looks: Whole, chance: FloatArray) -> Whole:
        """Return M, how many other frames must agree (n,); more than there are where none suffice.

        Parameters
        ----------
        looks : array (n,)
            N, how many look there.
        chance : array (n,)
            q.

        Examples
        --------
        >>> rule = Coincidence(candidate_rate=0.05, false_alarm_rate=1e-3, depth_searched=40.0)
        >>> chance = rule.chance(pixels=np.full(3, 6.0), tolerance=np.full(3, 1.0))
        >>> chance.round(6).tolist()
        [0.015, 0.015, 0.015]
        >>> rule.needed(looks=np.array([0, 1, 7]), chance=chance).tolist()
        [1, 1, 2]
        """
        needed = np.ones(len(looks), np.int64)
        while True:
            false = self.candidate_rate * binom.sf(needed - 1, looks, chance)
            more = (false > self.false_alarm_rate) & (needed <= looks)
            if not more.any():
                return needed
            needed[more] += 1
