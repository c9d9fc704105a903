"""The fast engine: one flash, from the laser to expected photo-electrons in every pixel.

Forward walks of every order run from the laser, backward walks from the pixels, and the two are
paired where they meet. Light that has touched the bottom is split at its last touch, so that both
walks may scatter at will. Light of the column is split at its last scattering by more than the
split angle; the walks after it scatter by no more than that angle. Paths of the column without any
such turn are left out: below 1e-4 of the light at 30 degrees.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from survey.flight.pose import Pose
from survey.flight.trajectory import footprint
from survey.optics.water import Water
from survey.sensor.camera import Camera
from survey.sensor.laser import Laser
from survey.sensor.receiver import Receiver
from survey.transport.glint import add_glint, add_mirror
from survey.transport.join import Echoes, join_in_column, join_on_patches
from survey.transport.launch import Address, Optics, launch_backward, launch_forward
from survey.transport.random import BACKWARD, RESTRICTED, SURFACE, chance
from survey.transport.records import LEDGER_NAMES, Records, empty_records, overflowed, trimmed
from survey.transport.scene import (
    Bounds,
    Layers,
    Medium,
    Scene,
    forward_medium,
    kernel_sea,
    restricted_medium,
)
from survey.transport.settings import TransportSettings
from survey.transport.waveforms import (
    PULSE_REACH,
    Waveforms,
    blurred,
    crossed_variance,
    padded_bins,
    pulse_taps,
)
from terrain.patches import patch_table
from terrain.sea_surface import SeaSurface

if TYPE_CHECKING:
    from terrain.seabed import Seabed

FloatArray = NDArray[np.float64]

COARSE_SHARE = 0.4
LAYER_OPTICAL = 0.2


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


def _until_it_fits(launch: Callable[[Records], None], *, arrivals: int, crossings: int) -> Records:
    """Launch into lists that are grown until nothing is cut off; the walks are the same again."""
    while True:
        records = empty_records(arrivals=arrivals, crossings=crossings)
        launch(records)
        if not overflowed(records):
            return trimmed(records)
        arrivals, crossings = (
            max(room, int(1.1 * needed))
            for room, needed in zip((arrivals, crossings), records.filled[:2], strict=True)
        )


class Engine:
    """What stays the same from flash to flash: seabed, sea, water, instrument, settings.

    Parameters
    ----------
    seabed : Seabed
        Mesh with reflectance; its grid and patches are built once.
    surface : SeaSurface
        Level and slopes of the sea.
    water : Water
        Its optical properties.
    laser, camera, receiver
        The instrument.
    photo_electrons_per_photon : float
        Optics transmission x detection efficiency [1].
    settings : TransportSettings
        Work and fineness.
    seed : int
        Seed of every random number.
    """

    def __init__(
        self,
        *,
        seabed: Seabed,
        surface: SeaSurface,
        water: Water,
        laser: Laser,
        camera: Camera,
        receiver: Receiver,
        photo_electrons_per_photon: float,
        settings: TransportSettings,
        seed: int,
    ) -> None:
        self.surface, self.water, self.settings, self.seed = surface, water, settings, seed
        self.laser, self.camera, self.receiver = laser, camera, receiver
        self.photo_electrons = laser.photons_per_pulse * photo_electrons_per_photon
        self._forward = forward_medium(water)
        self._backward = restricted_medium(water, split_angle=settings.split_angle)
        self._cosines = water.phase_function.cosine_table()
        self._grid = seabed.grid
        self._patches = patch_table(
            seabed.mesh, patch_size=settings.patch_size, reflectance=seabed.reflectance
        )
        self._reflectance = np.ascontiguousarray(seabed.reflectance, dtype=np.float64)
        self._bins, pad = padded_bins(
            start=receiver.gate_start,
            width=receiver.bin_width,
            bins=receiver.bins,
            sigma=laser.pulse_sigma,
        )
        self._thickness = min(
            settings.layer_thickness, LAYER_OPTICAL / max(water.attenuation, 1e-9)
        )
        self._coarse = max(1, int(laser.pulse_fwhm * COARSE_SHARE / receiver.bin_width))
        self._taps = pulse_taps(sigma=laser.pulse_sigma, width=receiver.bin_width, pad=pad)

    def flash(self, *, pose: Pose, frame: int) -> Waveforms:
        """Return the expected photo-electrons of one flash.

        Parameters
        ----------
        pose : Pose
            True pose of sensor and laser.
        frame : int
            Address of the flash: the same number draws the same walks.
        """
        optics = kernel_optics(camera=self.camera, receiver=self.receiver, pose=pose)
        scene = self._scene(pose, frame=frame)
        echoes, ledger = self._paired_walks(scene, optics, Address(self.seed, frame))
        mean, variance = self._estimate(echoes)
        surface = self._surface_echo(scene, optics)[None]
        grid = (3, optics.rows, optics.columns, self.receiver.bins)
        return Waveforms(
            photo_electrons=np.concatenate([surface, mean]).reshape(grid),
            variance=np.concatenate([np.zeros_like(surface), variance]).reshape(grid),
            bin_start=self.receiver.gate_start,
            bin_width=self.receiver.bin_width,
            ledger=dict(zip(LEDGER_NAMES, ledger.tolist(), strict=True)),
        )

    def _paired_walks(
        self, scene: Scene, optics: Optics, address: Address
    ) -> tuple[Echoes, FloatArray]:
        """Walk from both ends and pair; return the echoes and the energy ledger of one pulse."""
        forward = self._forward_walks(scene, optics, address)
        settings, pixels = self.settings, optics.rows * optics.columns
        seeing = self._backward_walks(
            scene, self._forward, optics, address, BACKWARD, settings.backward_walks_per_replicate
        )
        restricted = self._backward_walks(
            scene, self._backward, optics, address, RESTRICTED, settings.column_walks_per_replicate
        )
        echoes = self._empty_echoes(pixels)
        self._join_bottom(echoes, forward, seeing)
        self._join_column(echoes, scene, forward, restricted, address)
        return echoes, forward.ledger / settings.replicates

    def walk_forward(self, *, pose: Pose, frame: int) -> Records:
        """Return what the forward walks of a flash leave behind, for measuring their speed."""
        optics = kernel_optics(camera=self.camera, receiver=self.receiver, pose=pose)
        scene = self._scene(pose, frame=frame)
        return self._forward_walks(scene, optics, Address(self.seed, frame))

    def _forward_walks(self, scene: Scene, optics: Optics, address: Address) -> Records:
        batches, stride = self.settings.replicates, self.settings.forward_column_stride
        height = optics.position[2] - scene.sea.level
        length, width = (2.0 * half * height for half in (optics.half_forward, optics.half_right))
        spacing = (batches / self.settings.forward_walks_per_m2) ** 0.5
        along, across = (max(1, round(side / spacing)) for side in (length, width))

        def launch(records: Records) -> None:
            for batch in range(batches):
                launch_forward(
                    scene, self._forward, optics, records, address, batch, along, across,
                    stride, self.photo_electrons,
                )  # fmt: skip

        walks = batches * along * across
        crossings = 2 * walks // stride * scene.layers.planes
        return _until_it_fits(launch, arrivals=2 * walks, crossings=crossings)

    def _backward_walks(
        self,
        scene: Scene,
        medium: Medium,
        optics: Optics,
        address: Address,
        purpose: int,
        walks: int,
    ) -> Records:
        """Walk from every pixel: to the bottom in full, or restricted through the column."""
        batches, column = self.settings.replicates, purpose == RESTRICTED

        def launch(records: Records) -> None:
            for batch in range(batches):
                launch_backward(
                    scene, medium, optics, records, address, purpose, batch, walks, float(column)
                )

        launched = batches * walks * optics.rows * optics.columns
        crossings = 2 * launched * scene.layers.planes if column else 0
        return _until_it_fits(launch, arrivals=launched, crossings=crossings)

    def _join_bottom(self, echoes: Echoes, forward: Records, backward: Records) -> None:
        isolated = self.settings.illumination == "isolated"
        order = np.argsort(forward.patch, kind="stable")
        patches = forward.patch[order]
        first = np.searchsorted(patches, backward.patch, side="left")
        last = np.searchsorted(patches, backward.patch, side="right")
        join_on_patches(echoes, self._bins, forward, order, first, last, backward, isolated)

    def _join_column(
        self, echoes: Echoes, scene: Scene, forward: Records, backward: Records, address: Address
    ) -> None:
        layers = scene.layers
        join_in_column(
            echoes, self._bins, forward, backward,
            layers.planes * layers.across * layers.along,
            self._cosines, np.cos(self.settings.split_angle),
            self.water.scattering * layers.thickness / layers.cell**2,
            self.settings.illumination == "isolated", *address,
        )  # fmt: skip

    def _empty_echoes(self, pixels: int) -> Echoes:
        batches = self.settings.replicates
        return Echoes(
            mean=np.zeros((2, pixels, self._bins.number), np.float32),
            batches=np.zeros(
                (3, batches, 2, pixels, self._bins.number // self._coarse + 1), np.float32
            ),
            coarse=self._coarse,
        )

    def _estimate(self, echoes: Echoes) -> tuple[FloatArray, FloatArray]:
        """Return mean and squared standard error (2, pixels, bins), the pulse's width included.

        The error is told in coarse bins, within which the pulse makes all fine ones rise and fall
        together.
        """
        mean = np.stack([blurred(origin, self._taps) for origin in echoes.mean])
        width = self.receiver.bin_width * self._coarse
        reach = int(np.ceil(PULSE_REACH * self.laser.pulse_sigma / width)) + 1
        taps = pulse_taps(sigma=self.laser.pulse_sigma, width=width, pad=reach)
        variance = crossed_variance(echoes.batches, taps.astype(np.float32))
        fine = np.arange(self.receiver.bins) + (self._bins.number - self.receiver.bins) // 2
        return mean, variance[..., fine // self._coarse] / self._coarse**2

    def _surface_echo(self, scene: Scene, optics: Optics) -> FloatArray:
        histogram = np.zeros((optics.rows * optics.columns, self._bins.number))
        add = add_mirror if self.surface.slope_variance == 0.0 else add_glint
        add(histogram, self._bins, scene, optics, self.water.refractive_index, self.photo_electrons)
        return blurred(histogram, self._taps)

    def _scene(self, pose: Pose, *, frame: int) -> Scene:
        """Return the scene of a flash: one realisation of the facets, planes of the column."""
        key = int(chance(seed=self.seed, purpose=SURFACE, frame=frame).integers(1 << 63))
        bounds = self._bounds(pose)
        return Scene(
            sea=kernel_sea(self.surface, key=key),
            grid=self._grid,
            patches=self._patches,
            reflectance=self._reflectance,
            bounds=bounds,
            layers=self._layers(bounds),
        )

    def _bounds(self, pose: Pose) -> Bounds:
        """Return the lit rectangle with a margin that holds the light spread sideways."""
        outline = footprint(self.camera, pose, self.surface.level)
        margin = self._deepest() + self.receiver.aperture_radius
        west, south = outline.min(axis=0) - margin
        east, north = outline.max(axis=0) + margin
        return Bounds(west, east, south, north, self.receiver.gate_end)

    def _deepest(self) -> float:
        """Return the depth [m] that light can reach and come back from within the gate."""
        in_gate = self.receiver.bins * self.receiver.bin_width * self._forward.speed / 2.0
        return max(0.0, min(in_gate, self.surface.level - self._grid.z_low))

    def _layers(self, bounds: Bounds) -> Layers:
        thickness, cell = self._thickness, self.settings.cell_size
        return Layers(
            top=self.surface.level - 0.5 * thickness,
            thickness=thickness,
            planes=int(np.ceil(self._deepest() / thickness)) + 1,
            west=bounds.west,
            south=bounds.south,
            cell=cell,
            across=int(np.ceil((bounds.east - bounds.west) / cell)),
            along=int(np.ceil((bounds.north - bounds.south) / cell)),
        )
