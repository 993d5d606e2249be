"""What the command line can do, one file a room.

What a command needs is loaded when it runs, in its function: `--help`, the executor and the simulator, commands of the
same program, do not wait for libraries that they never use.
"""
