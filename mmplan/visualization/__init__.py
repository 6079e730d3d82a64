"""Pictures of plans and scenes: what there is to see, and three ways to draw it.

Parts (coloured surfaces) and a film (where they are when) make an exhibit. A live
viewer, a page that stands for itself, and pictures and videos show it.
"""
