"""What the times and numbers of a recording say of themselves: rates, spans, who meets whom, what no camera does."""
