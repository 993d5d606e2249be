"""Planning: from a learned path to a plan with its certificate, or to the reason why not."""
