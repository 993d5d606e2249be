"""Motions as files of other programs: tables, ROS 2 messages and bags, robot programs."""
