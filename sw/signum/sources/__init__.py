"""Sources of frames: files, ROS bags, cameras and the simulated world."""
