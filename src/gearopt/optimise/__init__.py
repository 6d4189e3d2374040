"""Problems, methods and certificates; it knows no gears."""
