"""What the sensor makes of a ray: colour, light and shadow; depth with its noise."""
