"""Blender add-on: marks the colliding faces of any mesh, and proves that shape keys have no self-collisions."""

from __future__ import annotations

bl_info = {
    "name": "Self-collisions of shape keys",
    "author": "The sscc authors",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "3D Viewport > Sidebar > sscc",
    "description": "Marks the colliding faces of any mesh, and proves that shape keys have no self-collisions",
    "category": "Mesh",
}

from . import panel


def register() -> None:
    panel.register()


def unregister() -> None:
    panel.unregister()
