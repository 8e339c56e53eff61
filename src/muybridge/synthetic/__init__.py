"""Scenes whose truth is known: a skinned person in a room, rendered here, with exact joints.

================  =========================================================================================
`scene`           `Scene`, `Person`, `demo_scene(seed)`, `render(scene, frame)`, `empty(scene, n)`, `truth(scene)`
`write`           `write_scene(scene, folder)`: videos, empty room, masks, calibration, truth, measures, job
`skinning`        `load_figure(name, cut, hair)`, `figure_names()`: the baked people; bones, skinning, the 15 joints
`figure_file`     reading them: cuts of clothes, hair, shoes
`dress`           loose clothes that move late
`motion`          `Motion`, `Recorded`, `perform(figure, motion)`: what a figure does, made or recorded
`clip`            `Motion`: what may be done and how; `Track`: what then was
`gaits`           walk, wave, crouch, punch: joint angles over time; `angles` turns bones by them
`planting`        feet on the floor that hardly slip, for motions told by angles
`footwork`        jog, hop, jump, turn, sidestep: told by where the feet go
`stepping`        footprints, free fall between them, and legs (`limbs`) that reach them
`recorded`        `Recorded`: a motion file, cut, resampled, placed
`retarget`        a recording's motion on a figure's bones; `bone_names`: which is which
`contacts`        feet of a recording: on the floor where they bear
`rigs`            `ring`, `looking_at`: where cameras stand
`rasterise`       `draw(camera, mesh ...)`: z-buffer, solid textures, Lambert shading
`benchmark`       `time_rendering()`: how fast that is
`room`            `Room`, `picture(room, camera)`: floor, walls, their light
`shadow`          the person's shadow on the floor
`textures`        noise and cloth
================  =========================================================================================
"""
