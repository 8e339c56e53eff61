"""Scenes whose truth is known: a skinned person in a room, rendered here, with exact joints.

================  =========================================================================================
`presets`         `preset_scene(name, seed=...)`: easy, studio, humaneva, hard
`surveillance`    `surveillance_scene(seed=...)`: one camera, people who come and go
`crowd`           `shoot_people(scene, frame)`: its pictures, and who is where in them; `crowd_files`: as files
`scene`           `demo_scene(seed)`, `render(scene, frame)`, `empty(scene, n)`, `truth(scene)`
`description`     `Scene`, `Person`: what a scene is made from
`scene_file`      `read(path)`: SCENE.toml -> `Scene`; `scene_text`: back again; `scene_tables`: its keys
`write`           `write_scene(scene, folder)`: a folder that `track` takes; `truth_files`: its tables of truth
`stage`           a scene's parts, made once
`measure`         `tracker_body(figure)`: the right body for a tracker

`skinning`        `load_figure(name, cut, hair)`, `figure_names()`: the baked people; bones, skinning, the 15 joints
`figure_file`     reading them: cuts of clothes, hair, shoes
`outfits`         what is worn; `dress`: loose clothes that move late; `wardrobe`: looks by chance

`motion`          `Motion`, `Recorded`, `perform(figure, motion)`: what a figure does, made or recorded
`clip`            `Motion`: what may be done and how; `Track`: what then was; `posture`: between two frames
`gaits`           walk, wave, punch: joint angles over time; `angles` turns bones by them
`lowered`         crouch, bend, lie: down and up again
`route`           walks through points of the floor, with stops, at one of which one may go down
`planting`        feet on the floor that hardly slip, for motions told by angles
`footwork`        jog, hop, jump, turn, sidestep: told by where the feet go
`stepping`        footprints, free fall between them, and legs (`limbs`) that reach them
`recorded`        `Recorded`: a motion file, cut, resampled, placed
`retarget`        a recording's motion on a figure's bones; `bone_names`: which is which
`contacts`        feet of a recording: on the floor where they bear

`rigs`            `ring`, `looking_at`: where cameras stand; `placing`: so that they see the person
`room`            `Room`, `picture(room, camera)`: floor, walls
`light`           lamps that drift and switch; `shadow`: shadows on the floor
`occluders`       things in the way; `obstacles`: what makes a scene hard
`sensor`          exposure, noise, shutter, compression

`rasterise`       `draw(camera, mesh ...)`: z-buffer, solid textures, Lambert shading; `textures`: noise and cloth
`compose`         several layers in one picture; `visibility`: how much of each segment is seen
`benchmark`       `time_rendering()`: how fast that is
================  =========================================================================================
"""
