"""The peer: Open3D's voxel block grid on the CPU, where Open3D is installed."""

from __future__ import annotations

import importlib.util

import numpy as np

from isr_jax.types import Camera, Frame

BLOCK_SIDES = (8, 16)
"""Side of its blocks, in voxels: its default is 16, and 8 is faster at small voxels."""
HOW_TO_GET = (
    "Open3D is not installed: ours alone. For the peers: pip install open3d scikit-image "
    "(and apt-get install libusb-1.0-0, which Open3D loads)"
)
_START_BLOCKS = 1 << 15
"""Room for the film at 1 cm, so that it need not grow; ours starts with as many there."""
_BYTES_PER_VOXEL = 8
"""Distance and weight, float32."""


def is_installed(package: str = "open3d") -> bool:
    """Whether a peer can be imported."""
    return importlib.util.find_spec(package) is not None


class Open3dMap:
    """Integrates geometry alone, no colour; voxel, truncation and depth range are ours."""

    def __init__(
        self, camera: Camera, side: int, voxel_m: float, truncation_voxels: float, far_m: float
    ) -> None:
        import open3d as o3d

        self._o3d, self._core, self.side = o3d, o3d.core, side
        self._K = self._core.Tensor(np.ascontiguousarray(camera.K))
        self._range = (1.0, far_m, truncation_voxels)
        float32, one = self._core.float32, self._core.SizeVector([1])
        device = self._core.Device("CPU:0")
        self._grid = o3d.t.geometry.VoxelBlockGrid(
            ("tsdf", "weight"), (float32, float32), (one, one), voxel_m, side, _START_BLOCKS, device
        )

    def prepared(self, frame: Frame):
        """Depth image and extrinsics as Open3D takes them; not part of the time per frame."""
        depth = self._core.Tensor(np.ascontiguousarray(frame.depth_m, np.float32))
        T_camera_world = np.linalg.inv(frame.T_world_camera.astype(np.float64))
        return self._o3d.t.geometry.Image(depth), self._core.Tensor(T_camera_world)

    def integrate(self, prepared) -> None:
        """Find the blocks near the surface, allocate them, update their voxels."""
        depth, extrinsic = prepared
        blocks = self._grid.compute_unique_block_coordinates(
            depth, self._K, extrinsic, *self._range
        )
        self._grid.integrate(blocks, depth, self._K, extrinsic, *self._range)

    def mesh(self, min_weight: float):
        """Its surface."""
        return self._grid.extract_triangle_mesh(min_weight)

    @property
    def nbytes(self) -> int:
        """Of the voxels in use."""
        return self._grid.hashmap().size() * self.side**3 * _BYTES_PER_VOXEL
