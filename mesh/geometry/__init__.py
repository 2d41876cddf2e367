"""The sphere and the plane, behind one interface (`surface`)."""
