"""The panel in the sidebar, its buttons, and the mark in the viewport."""

from __future__ import annotations

import bpy

from . import evaluated, proof
from .shape import Unsupported
from .status import Status

ICONS = {
    "free": "CHECKMARK",
    "colliding": "ERROR",
    "changed": "FILE_REFRESH",
    "uncertified": "QUESTION",
    "unsupported": "INFO",
}
RED = (1.0, 0.1, 0.05, 1.0)

_overlay = None


def _proof(context: bpy.types.Context) -> Status:
    """The status of the shape keys."""
    return proof.status(context.object, context.scene.sscc_ignore_rest)


def _evaluated(context: bpy.types.Context) -> Status | None:
    """The status of the evaluated mesh; None if it has not been checked."""
    return evaluated.status(context.object, context.evaluated_depsgraph_get())


def _shown(context: bpy.types.Context) -> Status:
    """The status that is marked and selected: of the evaluated mesh if it is known, else of the shape keys."""
    found = _evaluated(context)
    return found if found is not None and found.kind in ("free", "colliding") else _proof(context)


class SSCC_OT_certify(bpy.types.Operator):
    """Compute certificates of the active mesh and its shape keys"""

    bl_idname = "sscc.certify"
    bl_label = "Certify"

    def execute(self, context: bpy.types.Context) -> set[str]:
        manager = context.window_manager
        manager.progress_begin(0, 100)
        try:
            certified = proof.certify(
                context.object, context.scene.sscc_ignore_rest, lambda share: manager.progress_update(100 * share)
            )
        except (Unsupported, ValueError, MemoryError) as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        finally:
            manager.progress_end()
        self.report({"INFO"}, f"certified {len(certified.faces)} triangles")
        return {"FINISHED"}


class SSCC_OT_check_evaluated(bpy.types.Operator):
    """Find the faces of the active object that collide now, after armatures and all modifiers"""

    bl_idname = "sscc.check_evaluated"
    bl_label = "Check Evaluated Mesh"

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            found = evaluated.check(context.object, context.evaluated_depsgraph_get())
        except (Unsupported, ValueError, MemoryError) as refusal:
            self.report({"ERROR"}, str(refusal))
            return {"CANCELLED"}
        self.report({"INFO"}, found.text)
        _changed()
        return {"FINISHED"}


class SSCC_OT_select(bpy.types.Operator):
    """Select the faces that collide"""

    bl_idname = "sscc.select"
    bl_label = "Select Colliding Faces"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: bpy.types.Context) -> set[str]:
        status = _shown(context)
        if status.kind not in ("free", "colliding"):
            self.report({"ERROR"}, status.text)
            return {"CANCELLED"}
        if len(status.corners) > 0 and len(status.polygons) == 0:
            self.report({"ERROR"}, "modifiers change the faces: the colliding ones are only marked")
            return {"CANCELLED"}
        mesh = context.object.data
        mesh.vertices.foreach_set("select", [False] * len(mesh.vertices))
        # Edges keep their selection: Blender 5.0 crashes on the edges of meshes from `from_pydata`.
        chosen = [False] * len(mesh.polygons)
        for polygon in status.polygons:
            chosen[polygon] = True
        mesh.polygons.foreach_set("select", chosen)
        mesh.update()
        return {"FINISHED"}


class SSCC_PT_panel(bpy.types.Panel):
    """Whether the active mesh is free of self-collisions"""

    bl_label = "Self-collisions"
    bl_idname = "SSCC_PT_panel"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "sscc"

    def draw(self, context: bpy.types.Context) -> None:
        status = _proof(context)
        self.layout.label(text=status.text, icon=ICONS[status.kind])
        self.layout.prop(context.scene, "sscc_ignore_rest")
        self.layout.operator("sscc.certify")
        found = _evaluated(context)
        if found is not None:
            self.layout.label(text=found.text, icon=ICONS[found.kind])
        self.layout.operator("sscc.check_evaluated")
        self.layout.operator("sscc.select")
        self.layout.prop(context.scene, "sscc_mark")


def _draw_mark() -> None:
    """Draws the colliding triangles of the active mesh over it."""
    import gpu
    from gpu_extras.batch import batch_for_shader

    context = bpy.context
    if not context.scene.sscc_mark or context.object is None:
        return
    status = _shown(context)
    if status.kind != "colliding":
        return
    shader = gpu.shader.from_builtin("UNIFORM_COLOR")
    batch = batch_for_shader(shader, "TRIS", {"pos": status.corners.astype("f4")})
    gpu.state.depth_test_set("LESS_EQUAL")
    with gpu.matrix.push_pop():
        gpu.matrix.multiply_matrix(context.object.matrix_world)
        shader.uniform_float("color", RED)
        batch.draw(shader)
    gpu.state.depth_test_set("NONE")


@bpy.app.handlers.persistent
def _changed(*_: object) -> None:
    """Redraws the sidebars after a change. Blender redraws the viewports itself."""
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


CLASSES = (SSCC_OT_certify, SSCC_OT_check_evaluated, SSCC_OT_select, SSCC_PT_panel)
HANDLERS = (bpy.app.handlers.depsgraph_update_post, bpy.app.handlers.frame_change_post)


def register() -> None:
    global _overlay
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.Scene.sscc_ignore_rest = bpy.props.BoolProperty(
        name="Ignore Collisions of the Basis",
        description="Never report pairs of faces that collide in the basis, such as closed lips",
    )
    bpy.types.Scene.sscc_mark = bpy.props.BoolProperty(
        name="Mark in Viewport", description="Draw the colliding faces in red", default=True
    )
    for handler in HANDLERS:
        handler.append(_changed)
    _overlay = bpy.types.SpaceView3D.draw_handler_add(_draw_mark, (), "WINDOW", "POST_VIEW")


def unregister() -> None:
    global _overlay
    bpy.types.SpaceView3D.draw_handler_remove(_overlay, "WINDOW")
    _overlay = None
    for handler in HANDLERS:
        handler.remove(_changed)
    del bpy.types.Scene.sscc_mark
    del bpy.types.Scene.sscc_ignore_rest
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
    evaluated.forget()
    proof.forget()
