"""Files in and out, one module per format. Everything is read and written a frame at a time, in constant memory.

=====================  ==============================================================================
`video`                `open_pictures`, `open_masks`: a camera's pictures from a video or from numbered images
`video_reader`         `VideoReader`: frame-exact reading by timestamp
`image_sequence`       `ImageSequence`: `CAM1/image%04d.bmp` and `CAM1/*.png`
`video_writer`         `VideoWriter`: H.264 that browsers play
`mask_writer`          `MaskFolder`, `MaskVideo`: masks as PNGs or as a video
`synchronise`          `check_synchronised`, `synchronised`: several cameras as one stream
`run_folder`           `joints.csv`, `pose.csv`, `run.json`
`run_log`              the log that `--resume` continues from
`job`                  the job file: cameras, calibration, body, filter, settings
`skeleton`             `Skeleton`, `Recording`: bones and how they turn, whatever the file
`asf_amc`              `read_amc`: Acclaim's skeletons and motion, as CMU publishes them
`bvh`                  `read_bvh`: Biovision's
`trc`                  marker tables for OpenSim and its kin
`c3d`                  `read_c3d`: marker files of laboratories, by the optional package ezc3d
`boxes`                `BoxSeries`, `read_boxes`: several people's boxes, whatever the file
`mot`, `caviar`        MOTChallenge's text, CAVIAR's XML
`parts`                `parts.csv`: boxes of people's parts
`run_facts`            versions, memory and speed for `run.json`
`disk`                 `disk_errors`, `replace_file`: a full disk is one line; whole files or none
`prefetch`             `prefetched`: decode ahead in a thread
=====================  ==============================================================================
"""
