from reference.site_folder import arm_urdf, folder, plain

__all__ = ["arm_urdf", "folder", "plain"]
