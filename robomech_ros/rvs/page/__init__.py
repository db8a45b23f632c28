"""The page of the view, drawn with viser.

In all modules ``scene``, ``gui``, ``server`` and ``client`` are viser's SceneApi, GuiApi,
ViserServer and ClientHandle (a browser), and ``reach`` is the size of the robot (m).
"""
