"""Scenes whose truth is known: a skinned person in a room, rendered here, with exact joints.

================  =========================================================================================
`presets`         `preset_scene(name, seed=...)`: easy, studio, humaneva, hard
`scene`           `demo_scene(seed)`, `render(scene, frame)`, `empty(scene, n)`, `truth(scene)`
`description`     `Scene`, `Person`: what a scene is made from
`scene_file`      `read(path)`: SCENE.toml -> `Scene`; `scene_text`: back again; `scene_tables`: its keys
`write`           `write_scene(scene, folder)`: a folder that `track` takes; `truth_files`: its tables of truth
`skinning`        `load_figure(name)`: the baked people; bones, linear blend skinning, the 15 joints
`motion`          `Motion`, `perform(figure, motion)`; `posture`: a moment between two frames
`outfits`         what is worn
`rigs`            `ring`, `looking_at`: where cameras stand; `placing`: so that they see the person
`occluders`       things in the way; `obstacles`: what makes a scene hard
`stage`           a scene's parts, made once
`rasterise`       `draw(camera, mesh ...)`: z-buffer, solid textures, Lambert shading
`compose`         several layers in one picture; `visibility`: how much of each segment is seen
`room`            `Room`, `picture(room, camera)`: floor, walls, their light
`light`           lamps that drift and switch; `shadow`: shadows on the floor
`sensor`          exposure, noise, shutter, compression
`textures`        noise and cloth
================  =========================================================================================
"""
