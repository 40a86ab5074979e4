"""Self-collisions of meshes with shape keys: proven free, or marked in the viewport while sliders move."""

from __future__ import annotations

bl_info = {
    "name": "Self-collisions of shape keys",
    "author": "The sscc authors",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D Viewport > Sidebar > sscc",
    "description": "Proves that a mesh with shape keys is free of self-collisions, or marks where",
    "category": "Mesh",
}

from . import panel


def register() -> None:
    panel.register()


def unregister() -> None:
    panel.unregister()
