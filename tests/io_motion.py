"""Small motion files made by hand, for the readers' tests."""

from __future__ import annotations

ASF = """\
# by hand
:version 1.10
:name made
:units
  mass 1.0
  length 0.5
  angle deg
:documentation
  nothing
:root
  order TX TY TZ RX RY RZ
  axis XYZ
  position 0 0 0
  orientation 0 0 0
:bonedata
  begin
     id 1
     name thigh
     direction 0 -1 0
     length 8
     axis 0 0 20 XYZ
     dof rx rz
     limits (-90 90)
            (-90 90)
  end
  begin
     id 2
     name shank
     direction 0 -1 0
     length 7
     axis 0 0 0 XYZ
     dof rx
  end
  begin
     id 3
     name spine
     direction 0 1 0
     length 10
     axis 0 0 0 XYZ
  end
:hierarchy
  begin
    root thigh spine
    thigh shank
  end
"""
AMC = """\
#!OML:ASF made
:FULLY-SPECIFIED
:DEGREES
1
root 1 20 3 0 0 0
thigh 30 0
shank -40
2
root 2 20 3 0 90 0
thigh 0 10
shank 0
3
root 3 20 3 10 20 30
thigh 1 2
shank 3
"""
BVH = """\
HIERARCHY
ROOT Hips
{
	OFFSET 0 0 0
	CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation
	JOINT LeftUpLeg
	{
		OFFSET 10 0 0
		CHANNELS 3 Xrotation Zrotation Yrotation
		JOINT LeftFoot
		{
			OFFSET 0 -90 0
			CHANNELS 3 Zrotation Xrotation Yrotation
			End Site
			{
				OFFSET 0 -5 15
			}
		}
	}
	JOINT Head
	{
		OFFSET 0 70 0
		CHANNELS 3 Zrotation Xrotation Yrotation
		End Site
		{
			OFFSET 0 20 0
		}
	}
}
MOTION
Frames: 3
Frame Time: 0.04
1 95 2 0 0 0 0 0 0 0 0 0 0 0 0
2 95 2 10 20 30 40 50 60 0 0 0 0 0 0
3 95 2 0 90 0 0 0 0 0 0 0 0 0 0
"""
