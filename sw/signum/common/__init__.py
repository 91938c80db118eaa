"""What every room uses: types of arrays, errors for the user, and the terminal."""
