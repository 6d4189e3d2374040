"""What a scene's answer rests on, said in the numbers of its file."""
