"""Does a survey meet the order that was asked, and if not, why and where?"""
