"""What the answer to any problem file rests on, said in the numbers of the file."""
