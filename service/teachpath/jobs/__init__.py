"""Background work: learning and planning in processes of their own."""
