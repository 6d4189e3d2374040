"""What is used of the load capacity of a pair, of numbers and of arrays, and kernels of it."""
