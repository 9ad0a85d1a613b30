"""Slow twins of the mapping kernels, and rooms whose depth is known in closed form."""

from __future__ import annotations

import dataclasses

import numpy as np

from isr_jax.types import Camera, Frame, FrameSegments

CAMERA = Camera(fx=130.0, fy=130.0, cx=79.5, cy=59.5, width=160, height=120)


@dataclasses.dataclass(frozen=True)
class Solid:
    """A plane (n . x = d), a box (centre, half size, yaw) or a ball (centre, radius)."""

    kind: str
    a: tuple
    b: tuple | float
    yaw: float = 0.0
    class_id: int = 1
    color: tuple = (200, 100, 50)

    def hit(self, origin: np.ndarray, rays: np.ndarray) -> np.ndarray:
        """Ray parameter of the first hit, inf where there is none."""
        a = np.asarray(self.a, float)
        if self.kind == "plane":
            t = (self.b - origin @ a) / (rays @ a)
            return np.where(t > 1e-6, t, np.inf)
        if self.kind == "ball":
            to, half = origin - a, rays @ (origin - a)
            square = np.sum(rays**2, -1)
            root = half**2 - square * (to @ to - self.b**2)
            t = (-half - np.sqrt(np.maximum(root, 0))) / square
            return np.where((root > 0) & (t > 0), t, np.inf)
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        R = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        start, along = (origin - a) @ R, rays @ R
        with np.errstate(divide="ignore"):
            t = np.stack([(side * np.asarray(self.b) - start) / along for side in (-1, 1)])
        enter, leave = t.min(0).max(-1), t.max(0).min(-1)
        return np.where((enter < leave) & (enter > 0), enter, np.inf)

    def distance(self, p: np.ndarray) -> np.ndarray:
        """Unsigned distance of points to the surface."""
        a = np.asarray(self.a, float)
        if self.kind == "plane":
            return np.abs(p @ a - self.b)
        if self.kind == "ball":
            return np.abs(np.linalg.norm(p - a, axis=-1) - self.b)
        c, s = np.cos(self.yaw), np.sin(self.yaw)
        q = np.abs((p - a) @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])) - np.asarray(self.b)
        outside = np.linalg.norm(np.maximum(q, 0), axis=-1)
        return np.abs(outside + np.minimum(q.max(-1), 0))


def look_at(eye, target) -> np.ndarray:
    """T_world_camera of an OpenCV camera (x right, y down, z forward)."""
    z = np.subtract(target, eye)
    z = z / np.linalg.norm(z)
    x = np.cross(z, [0, 0, 1.0])
    x = x / np.linalg.norm(x)
    T = np.eye(4)
    T[:3, :3] = np.stack([x, np.cross(z, x), z], 1)
    T[:3, 3] = eye
    return T.astype(np.float32)


def render(solids, T_world_camera, camera: Camera = CAMERA, index=0, noise_m=0.0, seed=0):
    """A frame and its true segments: one per solid, in order, from 1."""
    v, u = np.mgrid[: camera.height, : camera.width]
    rays = np.stack([(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, np.ones_like(u)], -1)
    T = np.asarray(T_world_camera, float)
    hits = np.stack([s.hit(T[:3, 3], rays @ T[:3, :3].T) for s in solids])
    nearest, depth = hits.argmin(0), hits.min(0)
    seen = np.isfinite(depth) & (depth < 5.0)
    if noise_m:
        depth = depth + np.random.default_rng((seed, index)).normal(0, noise_m, depth.shape)
    depth = np.where(seen, depth, 0).astype(np.float32)
    segment = np.where(seen, nearest + 1, 0).astype(np.int32)
    color = np.array([(0, 0, 0), *(s.color for s in solids)], np.uint8)[segment]
    frame = Frame(index, f"{index:06d}", color, depth, np.asarray(T_world_camera), camera)
    class_id = np.array([0, *(s.class_id for s in solids)], np.int32)
    return frame, FrameSegments(segment, class_id, np.arange(len(class_id), dtype=np.int32))


def orbit(target, radius, height, count, turn=2 * np.pi):
    """Poses on a circle that look at its middle."""
    angles = np.linspace(0, turn, count, endpoint=False)
    eyes = [np.add(target, (radius * np.cos(a), radius * np.sin(a), height)) for a in angles + 0.3]
    return [look_at(eye, target) for eye in eyes]


def integrate_voxel(centers, frames, settings):
    """Running mean of the truncated distance at points, frame by frame, in float64."""
    voxel = settings.voxel_size_m
    tau = settings.truncation_voxels * voxel
    sdf, weight = np.zeros(len(centers)), np.zeros(len(centers))
    for frame in frames:
        R, t = frame.T_world_camera[:3, :3].astype(float), frame.T_world_camera[:3, 3].astype(float)
        p = (centers - t) @ R
        z = p[:, 2]
        cam = frame.camera
        with np.errstate(divide="ignore", invalid="ignore"):
            u = np.floor(p[:, 0] / z * cam.fx + cam.cx + 0.5)
            v = np.floor(p[:, 1] / z * cam.fy + cam.cy + 0.5)
        ok = (z > 0.05) & (u >= 0) & (u < cam.width) & (v >= 0) & (v < cam.height)
        depth = np.zeros(len(centers))
        depth[ok] = frame.depth_m[v[ok].astype(int), u[ok].astype(int)]
        with np.errstate(divide="ignore", invalid="ignore"):
            d = (depth - z) * np.linalg.norm(p, axis=1) / z
        ok &= (depth > 0) & (d > -tau)
        w = np.where(ok, np.clip((tau + d) / (tau - voxel), 0, 1) / np.where(ok, z, 1) ** 2, 0)
        total = weight + w
        share = np.divide(w, total, out=np.zeros_like(w), where=total > 0)
        sdf += (np.minimum(np.where(ok, d, 0), tau) - sdf) * share
        weight = np.minimum(total, settings.max_weight)
    return sdf, weight


def count_slots(slots, label, max_count):
    """One voxel's label slots [(count, label), ...] after one more count, as stated in words."""
    slots = [list(s) for s in slots]
    for slot in slots:
        if slot[0] and slot[1] == label:
            slot[0] = min(slot[0] + 1, max_count)
            break
    else:
        if slots[-1][0] > 1:
            slots[-1][0] -= 1
        else:
            slots[-1] = [1, label]
    return [tuple(s) for s in sorted(slots, key=lambda s: -s[0])]
