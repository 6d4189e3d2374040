"""The mesh load factor K_gamma of planetary stages."""

# by number of planets; unverified: gfsReboucas/Drivetrain, 1.10 of three printed in its reports
MESH_LOAD_FACTORS = {3: 1.10, 4: 1.25, 5: 1.35, 6: 1.44, 7: 1.47}
