"""What stands close beside the machine: do motions that lead away go, and does none go on into it?"""
