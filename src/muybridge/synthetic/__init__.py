"""Scenes whose truth is known: a skinned person in a room, rendered here, with exact joints.

================  =========================================================================================
`scene`           `Scene`, `Person`, `demo_scene(seed)`, `render(scene, frame)`, `empty(scene, n)`, `truth(scene)`
`write`           `write_scene(scene, folder)`: videos, empty room, masks, calibration, truth, measures, job
`skinning`        `load_figure(name, cut, hair)`, `figure_names()`: the baked people; bones, skinning, the 15 joints
`figure_file`     reading them: cuts of clothes, hair, shoes
`dress`           loose clothes that move late
`motion`          `Motion`, `perform(figure, motion)`: walk, wave, crouch
`rigs`            `ring`, `looking_at`: where cameras stand
`rasterise`       `draw(camera, mesh ...)`: z-buffer, solid textures, Lambert shading
`benchmark`       `time_rendering()`: how fast that is
`room`            `Room`, `picture(room, camera)`: floor, walls, their light
`shadow`          the person's shadow on the floor
`textures`        noise and cloth
================  =========================================================================================
"""
