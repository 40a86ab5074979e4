"""When a soft bar in MuJoCo, held in its middle, meets itself: its ends swing down and pass through each other.

    pip install mujoco
    python mujoco_bar.py
"""

from __future__ import annotations

import numpy as np
import sscc

SCENE = """
<mujoco>
  <option timestep="0.002" integrator="discrete"/>
  <worldbody>
    <flexcomp name="bar" type="grid" dim="3" count="25 3 3" spacing=".05 .05 .05" radius=".001" mass=".2"
              dof="trilinear" cellcount="8 1 1">
      <elasticity young="1e3" poisson=".2" damping=".01"/>
      <pin id="16 17 18 19"/>
      <contact selfcollide="none"/>
    </flexcomp>
  </worldbody>
</mujoco>
"""
STEPS = 350


def main() -> np.ndarray:
    import mujoco

    scene = mujoco.MjModel.from_xml_string(SCENE)
    data = mujoco.MjData(scene)

    # 225 vertices move with 36 nodes: q has 108 numbers.
    body, q_of = sscc.from_mujoco(scene, "bar")
    query = body.certify().kinetic()
    colliding = np.zeros(STEPS, bool)
    for step in range(STEPS):
        mujoco.mj_step(scene, data)
        colliding[step] = query.check(q_of(data)).colliding

    seconds = scene.opt.timestep * colliding.argmax()
    print(f"{colliding.sum()} of {STEPS} steps collide, the first one after {seconds:.2f} s")
    return colliding


if __name__ == "__main__":
    main()
