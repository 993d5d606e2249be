"""ROS 2 without ROS: topics over Zenoh, as rmw_zenoh and zenoh-bridge-ros2dds lay them out."""
