"""Pictures and masks -> evidence about a pose: `log_prob(poses (N, D)) -> (N,)`.

=============  =====================================================================================
observation    one frame's silhouettes and contour as the trackers see them; made by `ImageLikelihood`
silhouette     area of the silhouette: IoU (5.1), two-sided (12), one-sided
colour         histograms of the visible segments against a reference (5.3 to 5.7)
boundary       Fourier descriptor of the outer border (5.8 to 5.11)
edges          edges along the visible outlines (13)
cues           weights of the cues, and how each is made of a frame
fusion         cues as a product of powers (5.12), measured in one pass
contour        where the outline should move: residuals and derivatives
pictures       cameras, masks and pictures as the kernels take them
benchmark      microseconds per evaluation, and the same work in OpenCV and NumPy
=============  =====================================================================================
"""
