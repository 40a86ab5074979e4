"""Blender add-on: proves that a mesh with shape keys has no self-collisions, or marks the colliding faces."""

from __future__ import annotations

bl_info = {
    "name": "Self-collisions of shape keys",
    "author": "The sscc authors",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D Viewport > Sidebar > sscc",
    "description": "Proves that a mesh with shape keys has no self-collisions, or marks the colliding faces",
    "category": "Mesh",
}

from . import panel


def register() -> None:
    panel.register()


def unregister() -> None:
    panel.unregister()
