"""Model of the view, independent of any browser.

In all modules ``q`` is a posture (n,) of the n joints of a chain or mechanism (rad or m), ``T`` a
pose (4, 4) of its end in its base (m), and ``reach`` the size of the robot (m).
"""
