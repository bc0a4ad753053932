"""The map: landmarks with covariance in the odometry frame, and the free space that rays have shown."""
