"""The fast engine: one flash, from the laser to expected photo-electrons in every pixel.

Walks run back from the pixels; where they touch the bottom, and on their way through the column,
tracks of laser light are laid so that they lead there (`light_paths`). Paths of the column without
any scattering by more than the split angle are left out: at 45 degrees 0.1 % of the column's light.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import Pose
from survey.flight.trajectory import footprint
from survey.optics.water import Water, WaterColumn
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.allocation import deviations, strays, walks_of_pixels
from survey.transport.glint import add_glint, add_mirror
from survey.transport.launch import Optics
from survey.transport.layers import kernel_layers
from survey.transport.light_sent import Method
from survey.transport.pixels import LEDGER_NAMES, Address, see_all
from survey.transport.scene import Bounds, Scene, drawn_sea, facet_sea
from survey.transport.settings import TransportSettings
from survey.transport.surface import NORMAL_QUANTILES
from survey.transport.tally import LEG, Tally
from survey.transport.tracks import draw_tracks
from survey.transport.waveforms import (
    PULSE_REACH,
    Waveforms,
    blurred,
    padded_bins,
    pulse_taps,
)
from terrain.kernels import compiled_before
from terrain.sea_surface import SeaSurface
from terrain.seabed_grid import elevations_within

if TYPE_CHECKING:
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

COARSE_SHARE = 0.4
AZIMUTHS = 256
EARLY = 0.5
"""Delay of what still counts as early on one of its ways, in widths of the pulse [1]."""
FEWEST_LEGS, MOST_LEGS = 6, 24
LEGS_PER_SCATTERING, LEGS_BESIDE = 3, 64
TO_A_MILLIMETRE = 3


def kernel_optics(*, camera: Camera, receiver: Receiver, pose: Pose) -> Optics:
    """Return camera and aperture at a pose, as kernels take them."""
    half_forward, half_right = camera.half_tangents
    return Optics(
        position=np.asarray(pose.position, dtype=np.float64),
        turn=pose.body_to_map(),
        half_forward=half_forward,
        half_right=half_right,
        rows=camera.rows,
        columns=camera.columns,
        columns_forward=camera.long_side == "along",
        aperture_radius=receiver.aperture_radius,
    )


class Engine:
    """What stays the same from flash to flash: seabed, sea, water, instrument, settings.

    Parameters
    ----------
    seabed : Seabed
        Mesh with reflectance and its grid.
    surface : SeaSurface
        Level and slopes of the sea.
    water : Water or WaterColumn
        Its optical properties, at all depths or by depth.
    laser, camera, receiver
        The instrument.
    photo_electrons_per_photon : float
        Optics transmission x detection efficiency [1].
    settings : TransportSettings
        Work and method.
    seed : int
        Seed of every random number.
    """

    def __init__(
        self,
        *,
        seabed: Seabed,
        surface: SeaSurface,
        water: Water | WaterColumn,
        laser: Laser,
        camera: Camera,
        receiver: Receiver,
        photo_electrons_per_photon: float,
        settings: TransportSettings,
        seed: int,
    ) -> None:
        self.water = WaterColumn.of(water)
        self.surface, self.settings, self.seed = surface, settings, seed
        self.laser, self.camera, self.receiver = laser, camera, receiver
        self.photo_electrons = laser.photons_per_pulse * photo_electrons_per_photon
        self._layers = kernel_layers(self.water)
        self._grid = seabed.grid
        self._reflectance = np.ascontiguousarray(seabed.reflectance, dtype=np.float64)
        self._method = self._light_paths()
        self._bins, pad = padded_bins(
            start=receiver.gate_start,
            width=receiver.bin_width,
            bins=receiver.bins,
            sigma=laser.pulse_sigma,
        )
        self._coarse = max(1, int(laser.pulse_fwhm * COARSE_SHARE / receiver.bin_width))
        self._taps = pulse_taps(sigma=laser.pulse_sigma, width=receiver.bin_width, pad=pad)
        width = receiver.bin_width * self._coarse
        reach = int(np.ceil(PULSE_REACH * laser.pulse_sigma / width)) + 1
        self._coarse_taps = pulse_taps(sigma=laser.pulse_sigma, width=width, pad=reach)

    @staticmethod
    def compiled_before() -> bool:
        """Return whether a flash can be flown at once, without a minute of compiling first."""
        return compiled_before(see_all)

    def flash(self, *, pose: Pose, frame: int, time: float = 0.0) -> Waveforms:
        """Return the expected photo-electrons of one flash.

        Parameters
        ----------
        pose : Pose
            True pose of sensor and laser.
        frame : int
            Address of the flash: the same number draws the same walks.
        time : float
            When the flash is: the waves move [s].
        """
        optics = kernel_optics(camera=self.camera, receiver=self.receiver, pose=pose)
        scene = self._scene(pose, time)
        settings, address = self.settings, Address(self.seed, frame)
        scatterings = 2.0 * float(self.water.scattered(scene.bounds.depth))
        tracks = draw_tracks(
            self._layers, 2 * settings.replicates, settings.tracks_per_replicate,
            FEWEST_LEGS + int(min(MOST_LEGS, scatterings)), scene.bounds.depth, self._detour,
            *address,
        )  # fmt: skip
        deviation, rims = deviations(scene, optics, strays(tracks), self._method.isolated)
        walks = walks_of_pixels(deviation, mean=settings.walks_per_replicate)
        pixels, tally = len(walks), self._tally()
        mean = np.empty((3, pixels, self.receiver.bins), np.float32)
        variance = np.empty_like(mean)
        variance[0] = 0.0
        mean[0] = self._surface_echo(scene, optics)
        see_all(
            scene, self._layers, optics, self._method, tracks, tally, address,
            walks, rims, np.empty(2, np.uint64), mean[1:], variance[1:],
        )  # fmt: skip
        launched = settings.replicates * walks.sum()
        grid = (3, optics.rows, optics.columns, self.receiver.bins)
        return Waveforms(
            photo_electrons=mean.reshape(grid),
            variance=variance.reshape(grid),
            bin_start=self.receiver.gate_start,
            bin_width=self.receiver.bin_width,
            scatterings=int(tally.noted[1]),
            ledger=dict(zip(LEDGER_NAMES, (tally.ledger / launched).tolist(), strict=True)),
        )

    @property
    def _deepest_in_gate(self) -> float:
        return 0.5 * self.receiver.bins * self.receiver.bin_width * self._layers.speed

    @property
    def _detour(self) -> float:
        """Return what early light may go farther than straight light on one of its ways [m]."""
        return EARLY * self.laser.pulse_fwhm * self._layers.speed

    def _column_spacing(self) -> float:
        """Return the scatterings between points of a track: attenuation lengths, times b / c."""
        mean = self.water.mean(self._deepest_in_gate)
        if mean.scattering == 0.0:
            return np.inf
        return self.settings.column_spacing * mean.scattering / mean.attenuation

    def _light_paths(self) -> Method:
        azimuth = 2.0 * np.pi * np.arange(AZIMUTHS) / AZIMUTHS
        return Method(
            split_cosine=float(np.cos(self.settings.split_angle)),
            spacing=self._column_spacing(),
            isolated=self.settings.illumination == "isolated",
            photons=self.photo_electrons,
            quantiles=NORMAL_QUANTILES,
            circle=np.column_stack([np.cos(azimuth), np.sin(azimuth)]),
        )

    def _tally(self) -> Tally:
        """Return empty notes; a track that scatters thrice as often as expected is cut short."""
        legs = LEGS_BESIDE + int(
            LEGS_PER_SCATTERING * 2.0 * self._deepest_in_gate * self._layers.scattering.max()
        )
        coarse_bins = self._bins.number // self._coarse + 1
        return Tally(
            bins=self._bins,
            width=self._coarse,
            fine=np.empty((2, self._bins.number), np.float32),
            coarse=np.empty((self.settings.replicates, 2, coarse_bins), np.float32),
            down=np.empty((legs, len(LEG))),
            back=np.empty((legs, len(LEG))),
            noted=np.zeros(2, np.int64),
            ledger=np.zeros(len(LEDGER_NAMES)),
            taps=self._taps.astype(np.float32),
            coarse_taps=self._coarse_taps.astype(np.float32),
            rows=np.empty((3, coarse_bins + len(self._coarse_taps)), np.float32),
        )

    def _surface_echo(self, scene: Scene, optics: Optics) -> FloatArray:
        histogram = np.zeros((optics.rows * optics.columns, self._bins.number), np.float32)
        mirror = self.surface.slope_variance == 0.0 and not scene.wavy
        add = add_mirror if mirror else add_glint
        add(histogram, self._bins, scene, optics, self.water.refractive_index, self.photo_electrons)
        return blurred(histogram, self._taps)

    def _scene(self, pose: Pose, time: float) -> Scene:
        """Return the scene of a flash: the box around the lit water and the seabed in it."""
        surface = self.surface.at(time)
        outline, level = footprint(self.camera, pose, surface.level), surface.level
        deepest = max(0.0, min(self._deepest_in_gate, level - self._grid.z_low))
        margin = deepest + self.receiver.aperture_radius
        west, south = outline.min(axis=0) - margin
        east, north = outline.max(axis=0) + margin
        waves = surface.sheet(time=time, west=west, east=east, south=south, north=north)
        lowest, highest, top = elevations_within(
            self._grid, west=west, east=east, south=south, north=north
        )
        return Scene(
            sea=facet_sea(surface),
            drawn=drawn_sea(surface),
            wavy=surface.waves is not None,
            waves=waves,
            grid=self._grid,
            reflectance=self._reflectance,
            bounds=Bounds(
                west=west,
                east=east,
                south=south,
                north=north,
                lowest=lowest,
                highest=highest,
                depth=round(min(max(level - top, 0.0), self._deepest_in_gate), TO_A_MILLIMETRE),
                latest=self.receiver.gate_end,
            ),
        )
